// A tuning fork of square bars: two tines, a yoke and a stem, of bricks with 20 nodes. Millimetres.
// The tines point along z and vibrate along x; the fork is `depth` thick along y.
If (!Exists(mesh_size)) mesh_size = 3; EndIf
tine = 4; gap = 6; depth = 4; length = 90; yoke = 8; stem = 6;

// Corners in the plane y = 0: columns at the sides of the tines, rows at the ends of the parts.
x[] = {-gap/2 - tine, -gap/2, gap/2, gap/2 + tine};
z[] = {-stem, 0, yoke, yoke + length};
For j In {0:3}
  For i In {0:3}
    p = newp; corner[4*j + i] = p;
    Point(p) = {x[i], -depth/2, z[j]};
  EndFor
EndFor

// Cells that are solid: stem (column 1, row 0), yoke (row 1), tines (columns 0 and 2, row 2).
cells[] = {1,0,  0,1, 1,1, 2,1,  0,2, 2,2};
For c In {0:5}
  i = cells[2*c]; j = cells[2*c + 1];
  a = corner[4*j + i]; b = corner[4*j + i + 1]; d = corner[4*(j+1) + i]; e = corner[4*(j+1) + i + 1];
  l1 = newl; Line(l1) = {a, b}; l2 = newl; Line(l2) = {b, e};
  l3 = newl; Line(l3) = {e, d}; l4 = newl; Line(l4) = {d, a};
  Transfinite Curve{l1, l3} = Ceil((x[i+1] - x[i])/mesh_size) + 1;
  Transfinite Curve{l2, l4} = Ceil((z[j+1] - z[j])/mesh_size) + 1;
  loop = newll; Curve Loop(loop) = {l1, l2, l3, l4};
  s = news; Plane Surface(s) = {loop};
  Transfinite Surface{s}; Recombine Surface{s};
  faces[c] = s;
EndFor
Coherence;

For c In {0:5}
  out[] = Extrude {0, depth, 0} { Surface{faces[c]}; Layers{Ceil(depth/mesh_size)}; Recombine; };
  bars[c] = out[1];
EndFor
Coherence;
Physical Volume("steel") = {bars[]};
Mesh.SecondOrderIncomplete = 1;
