"""The mesh of the sphere on a plane, a quarter of it, finer towards the contact: python sphere.py  (gmsh 4.15)"""

import math

import gmsh

RADIUS, FINE, COARSE = 0.01, 0.00014, 0.003  # m
FOOT = math.radians(12)  # half of the cap that may touch

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
# A quarter of a sphere that stands on y = 0: x >= 0 and z >= 0, cut at the height of the cap.
ball = occ.addSphere(0, RADIUS, 0, RADIUS)
quarter = occ.addBox(0, 0, 0, RADIUS, 2 * RADIUS, RADIUS)
(body,), _ = occ.intersect([(3, ball)], [(3, quarter)])
height = RADIUS * (1 - math.cos(FOOT))
cap = occ.addBox(0, 0, 0, RADIUS, height, RADIUS)
parts, _ = occ.fragment([body], [(3, cap)])
occ.synchronize()
# The box of the cap leaves what is outside the sphere: only parts whose mass centre is inside stay.
inside, outside = [], []
for dim, tag in gmsh.model.getEntities(3):
    x, y, z = occ.getCenterOfMass(3, tag)
    (inside if x * x + (y - RADIUS) ** 2 + z * z < RADIUS**2 else outside).append((dim, tag))
occ.remove(outside, recursive=True)
occ.synchronize()
surfaces = {"foot": [], "x": [], "z": []}
for dim, tag in gmsh.model.getBoundary(inside, oriented=False):
    x0, y0, z0, x1, y1, z1 = gmsh.model.getBoundingBox(2, tag)
    small = 1e-6
    if x1 < small:
        surfaces["x"].append(tag)
    elif z1 < small:
        surfaces["z"].append(tag)
    elif occ.getCenterOfMass(2, tag)[1] < height:
        surfaces["foot"].append(tag)
field = gmsh.model.mesh.field
near = field.add("MathEval")
field.setString(near, "F", f"{FINE} + {COARSE - FINE} * (max(sqrt(x^2 + y^2 + z^2) - 0.0014, 0) / {2 * RADIUS})^0.8")
field.setAsBackgroundMesh(near)
for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
    gmsh.option.setNumber("Mesh." + option, 0)
gmsh.model.addPhysicalGroup(3, [tag for _, tag in inside], name="body")
for name, tags in surfaces.items():
    gmsh.model.addPhysicalGroup(2, tags, name=name)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.optimize("Netgen")
gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
gmsh.write("sphere.msh")
n = len(gmsh.model.mesh.getNodes()[0])
print(n, [len(t) for t in gmsh.model.mesh.getElements(3)[1]], {k: v for k, v in surfaces.items()})
gmsh.finalize()
