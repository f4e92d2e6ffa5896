"""Small meshes by Gmsh 4.15, as text and binary: a plate 2 x 1 and a cube with the group `base` at the bottom.

    pip install gmsh==4.15.2 && python tests/data/gmsh/meshes.py
"""
import pathlib

import gmsh

FOLDER = pathlib.Path(__file__).parent


def plate(h, bricks):
    surface = gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
    gmsh.model.occ.synchronize()
    base = [tag for _, tag in gmsh.model.getBoundary([(2, surface)], oriented=False)
            if gmsh.model.getBoundingBox(1, tag)[4] < 0.5]
    gmsh.model.addPhysicalGroup(1, base, name="base")
    gmsh.model.addPhysicalGroup(2, [surface], name="plate")
    if bricks:
        gmsh.option.setNumber("Mesh.RecombineAll", 1)


def block(h, bricks):
    if bricks:
        surface = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.extrude([(2, surface)], 0, 0, 1, [2], recombine=True)
        gmsh.option.setNumber("Mesh.RecombineAll", 1)
    else:
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    base = [tag for _, tag in gmsh.model.getEntities(2) if gmsh.model.getBoundingBox(2, tag)[5] < 0.5]
    gmsh.model.addPhysicalGroup(2, base, name="base")
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="block")
    if bricks:
        for _, tag in gmsh.model.getEntities(1):
            gmsh.model.mesh.setTransfiniteCurve(tag, 3)
        for _, tag in gmsh.model.getEntities(2):
            gmsh.model.mesh.setTransfiniteSurface(tag)


for name, build, dimension, h, order, bricks in [
    ("plate-1", plate, 2, 0.6, 1, False), ("plate-2", plate, 2, 0.6, 2, False), ("quads", plate, 2, 0.6, 2, True),
    ("block-1", block, 3, 0.9, 1, False), ("block-2", block, 3, 0.9, 2, False), ("bricks", block, 3, 0.5, 2, True),
]:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", h)
    gmsh.option.setNumber("Mesh.MeshSizeMax", h)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    build(h, bricks)
    gmsh.model.mesh.generate(dimension)
    gmsh.model.mesh.setOrder(order)
    for form, binary in (("text", 0), ("binary", 1)):
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(FOLDER / f"{name}-{form}.msh"))
    gmsh.finalize()
