// A part a number (gmsh -setnumber part ...); its numbers, turn and place are given by the caller.
SetFactory("OpenCASCADE");
DefineConstant[ part = 0, a = 60, b = 40, c = 8, r = 5, size = 6, tx = 0, ty = 0, tz = 0, mx = 0, my = 0, mz = 0 ];
If (part == 0)  // block with rounded edges
  Box(1) = {0, 0, 0, a, b, 3 * c};
  e() = Abs(Boundary{ Boundary{ Volume{1}; } });
  Fillet{1}{e()}{c / 3}
EndIf
If (part == 1)  // plate with a slot and holes
  Box(1) = {0, 0, 0, a, b, c / 4};
  Box(2) = {a / 4, b / 2, -1, a / 2, b / 10, c + 2};
  Cylinder(3) = {a / 5, b / 4, -1, 0, 0, c + 2, r / 2};
  Cylinder(4) = {4 * a / 5, b / 4, -1, 0, 0, c + 2, r / 2};
  BooleanDifference(5) = { Volume{1}; Delete; }{ Volume{2, 3, 4}; Delete; };
EndIf
If (part == 2)
  Torus(1) = {0, 0, 0, b / 2, r};
EndIf
If (part == 3)  // cross of pipes
  Cylinder(1) = {0, 0, -a / 2, 0, 0, a, r};
  Cylinder(2) = {-a / 2, 0, 0, a, 0, 0, 0.8 * r};
  BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
  Cylinder(4) = {0, 0, -a, 0, 0, 2 * a, r / 2};
  BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
EndIf
If (part == 4)
  Cone(1) = {0, 0, 0, 0, 0, a, b / 2, r / 4};
EndIf
If (part == 5)  // ball with a flat and a bore
  Sphere(1) = {0, 0, 0, b / 2};
  Box(2) = {-b, -b, 0.3 * b, 2 * b, 2 * b, b};
  Cylinder(3) = {0, 0, -b, 0, 0, 2 * b, r / 2};
  BooleanDifference(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
EndIf
If (part == 6)  // wedge
  Wedge(1) = {0, 0, 0, a, b, c, a / 8};
EndIf
Rotate{{1, 0, 0}, {0, 0, 0}, tx}{ Volume{:}; }
Rotate{{0, 1, 0}, {0, 0, 0}, ty}{ Volume{:}; }
Rotate{{0, 0, 1}, {0, 0, 0}, tz}{ Volume{:}; }
Translate{mx, my, mz}{ Volume{:}; }
Mesh.MeshSizeMax = size;
Mesh.MeshSizeFromCurvature = 10;
