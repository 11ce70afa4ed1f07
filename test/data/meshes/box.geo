// A box of 2 x 1 x 1 with a physical volume and a physical surface: the mesh of every fixture in this directory.
h = 0.5;
Point(1) = {0, 0, 0, h};
Point(2) = {2, 0, 0, h};
Point(3) = {2, 1, 0, h};
Point(4) = {0, 1, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Extrude {0, 0, 1} { Surface{1}; }
Physical Volume("tissue body", 7) = {1};
Physical Surface("base", 8) = {1};
