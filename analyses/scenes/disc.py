"""The mesh of the disc on a plane, finer towards the contact: python disc.py  (gmsh 4.15)"""

import math

import gmsh

RADIUS, FINE, COARSE = 0.05, 0.001, 0.008  # m
FOOT = math.radians(10)  # half of the arc that may touch

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
geo = gmsh.model.geo
centre = geo.addPoint(0, RADIUS, 0)
angles = [-math.pi / 2 - FOOT, -math.pi / 2 + FOOT, math.pi / 6, 5 * math.pi / 6]
rim = [geo.addPoint(RADIUS * math.cos(a), RADIUS + RADIUS * math.sin(a), 0) for a in angles]
arcs = [geo.addCircleArc(rim[i], centre, rim[(i + 1) % 4]) for i in range(4)]
disc = geo.addPlaneSurface([geo.addCurveLoop(arcs)])
geo.synchronize()
field = gmsh.model.mesh.field
near = field.add("MathEval")
field.setString(near, "F", f"{FINE} + {COARSE - FINE} * sqrt(x^2 + y^2) / {2 * RADIUS}")
field.setAsBackgroundMesh(near)
for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
    gmsh.option.setNumber("Mesh." + option, 0)
gmsh.model.addPhysicalGroup(2, [disc], name="body")
gmsh.model.addPhysicalGroup(1, [arcs[0]], name="foot")
gmsh.model.mesh.generate(2)
gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
gmsh.write("disc.msh")
gmsh.finalize()
