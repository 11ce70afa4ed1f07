// The block of step_costs refined around the way of the ball: cells of `h` within 7 mm of where its centre goes at first touch,
// then h + 0.35 (distance - 7 mm), at most 12 mm.
// usage: gmsh -3 -format msh22 -setnumber h 0.0014 refined_block.geo -o refined.msh
DefineConstant[ h = 0.0014 ];
SetFactory("OpenCASCADE");
Box(1) = {-0.05, -0.05, 0, 0.1, 0.1, 0.04};
Point(1001) = {-0.01, 0, 0.045};
Point(1002) = {0, 0, 0.045};
Line(1001) = {1001, 1002};
Field[1] = Distance;
Field[1].CurvesList = {1001};
Field[1].NumPointsPerCurve = 200;
Field[2] = MathEval;
Field[2].F = Sprintf("Min(0.012, %g + 0.35*Max(0, F1-0.007))", h);
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Physical Volume("all") = {1};
