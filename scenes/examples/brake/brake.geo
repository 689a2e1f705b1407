// Disc brake with ventilated disc, hat and two pads: own geometry script (Gmsh, OpenCASCADE kernel).
// Dimensions in metres, from the ANSYS Technology Showcase example "Brake squeal analysis".
// Meshed by a scene of this folder, or: gmsh -3 -setnumber mesh_size 0.008 -o brake.msh brake.geo
//   mesh_size  element size (m): 0.014 gives 27,000 nodes, 0.009 57,000, 0.0068 95,000
//   gap     distance pad - disc in the drawing (the contact closes it): published 1e-4
//   part    0 disc and pads, 1 disc only, 2 the lower pad only, 3 the upper one
SetFactory("OpenCASCADE");
DefineConstant[ mesh_size = 0.010, gap = 0.0001, part = 0 ];

// --- numbers -------------------------------------------------------------
ri = 0.125;  ro = 0.175;  tp = 0.010;          // the two friction rings
zv = 0.015;                                    // height of the vanes between them
nv = 21;     wv = 0.0286981;                   // vanes: number, width (straight, parallel sides)
ov = 0.0006105;                                // offset of a vane's middle line from the radius it follows
hi = 0.105;  ho = 0.1125; hh = 0.075;          // hat: inner, outer radius, height
bi = 0.040;  hz = 0.065;                       // hub plate: bore radius, lower face
nb = 5;      rb = 0.075;  db = 0.010;          // bolt holes: number, pitch radius, hole radius
pi1 = 0.130; po = 0.1675; tpad = 0.015;        // pads: radii, thickness
pa = Pi/3;                                     // pads: angle, from 60 to 120 degrees
eps = 1e-5;
H = 2*tp + zv;                                 // 0.035, upper friction face

// --- disc ----------------------------------------------------------------
If (part < 2)
Cylinder(1) = {0,0,0,    0,0,tp, ro};  Cylinder(2) = {0,0,0,    0,0,tp, ri};
BooleanDifference(10) = { Volume{1}; Delete; }{ Volume{2}; Delete; };           // ring, lower face z = 0
Cylinder(1) = {0,0,tp+zv, 0,0,tp, ro}; Cylinder(2) = {0,0,tp+zv, 0,0,tp, ri};
BooleanDifference(11) = { Volume{1}; Delete; }{ Volume{2}; Delete; };           // ring, upper face z = H
Cylinder(1) = {0,0,0,    0,0,tp, ri};  Cylinder(2) = {0,0,0,    0,0,tp, ho};
BooleanDifference(12) = { Volume{1}; Delete; }{ Volume{2}; Delete; };           // neck between hat and lower ring
Cylinder(1) = {0,0,0,    0,0,hh, ho};  Cylinder(2) = {0,0,0,    0,0,hh, hi};
BooleanDifference(13) = { Volume{1}; Delete; }{ Volume{2}; Delete; };           // hat
Cylinder(1) = {0,0,hz,   0,0,hh-hz, hi}; Cylinder(2) = {0,0,hz, 0,0,hh-hz, bi};
For k In {0:nb-1}
  a = Pi/2 + 2*Pi*k/nb;
  Cylinder(3+k) = {rb*Cos(a), rb*Sin(a), hz, 0,0,hh-hz, db};
EndFor
BooleanDifference(14) = { Volume{1}; Delete; }{ Volume{2:2+nb}; Delete; };      // hub plate
vanes() = {};
For k In {0:nv-1}
  Cylinder(1) = {0,0,tp, 0,0,zv, ro};  Cylinder(2) = {0,0,tp, 0,0,zv, ri};
  BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
  Box(4) = {ov-wv/2, ri/2, tp, wv, ro, zv};                                     // along +y, then turned
  Rotate { {0,0,1}, {0,0,0}, -2*Pi*k/nv } { Volume{4}; }
  BooleanIntersection(100+k) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
  vanes() += 100+k;
EndFor
disc() = BooleanFragments{ Volume{10:14}; Delete; }{ Volume{vanes()}; Delete; };
Physical Volume("disc") = disc();

big() = Surface In BoundingBox{-ro-eps,-ro-eps,-eps, ro+eps,ro+eps,eps};
sml() = Surface In BoundingBox{-ri-eps,-ri-eps,-eps, ri+eps,ri+eps,eps};
big() -= sml();
Physical Surface("disc_lower") = big();                                          // z = 0
top() = Surface In BoundingBox{-ro-eps,-ro-eps,H-eps, ro+eps,ro+eps,H+eps};
Physical Surface("disc_upper") = top();                                          // z = H
held() = Surface In BoundingBox{-bi-eps,-bi-eps,hz-eps, bi+eps,bi+eps,hh+eps};
For k In {0:nb-1}
  a = Pi/2 + 2*Pi*k/nb;  x = rb*Cos(a);  y = rb*Sin(a);
  held() += Surface In BoundingBox{x-db-eps,y-db-eps,hz-eps, x+db+eps,y+db+eps,hh+eps};
EndFor
Physical Surface("held") = held();                                               // bore and bolt holes, all directions
EndIf

// --- pads ----------------------------------------------------------------
If (part != 1)
first = (part == 3) ? 1 : 0;  last = (part == 2) ? 0 : 1;
For s In {first:last}
  z0 = (s == 0) ? -gap-tpad : H+gap;
  Cylinder(201) = {0,0,z0, 0,0,tpad, po, pa};  Cylinder(202) = {0,0,z0, 0,0,tpad, pi1, pa};
  BooleanDifference(210+s) = { Volume{201}; Delete; }{ Volume{202}; Delete; };
  Rotate { {0,0,1}, {0,0,0}, Pi/2-pa/2 } { Volume{210+s}; }
EndFor
x1 = -po; x2 = po; y1 = 0; y2 = po;
If (part != 3)
Physical Volume("pad_lower") = {210};
Physical Surface("pad_lower_face") = Surface In BoundingBox{x1,y1,-gap-eps, x2,y2+eps,-gap+eps};
Physical Surface("pad_lower_back") = Surface In BoundingBox{x1,y1,-gap-tpad-eps, x2,y2+eps,-gap-tpad+eps};
EndIf
If (part != 2)
Physical Volume("pad_upper") = {211};
Physical Surface("pad_upper_face") = Surface In BoundingBox{x1,y1,H+gap-eps, x2,y2+eps,H+gap+eps};
Physical Surface("pad_upper_back") = Surface In BoundingBox{x1,y1,H+gap+tpad-eps, x2,y2+eps,H+gap+tpad+eps};
EndIf
EndIf

// --- mesh ----------------------------------------------------------------
Mesh.MeshSizeMin = mesh_size/4;  Mesh.MeshSizeMax = mesh_size;
Mesh.MeshSizeFromCurvature = 10;
Mesh.MeshSizeExtendFromBoundary = 1;
Mesh.Algorithm = 6;
Mesh.Optimize = 1;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 0;
