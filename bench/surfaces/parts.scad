// A part a name; its numbers, turn and place are given by the caller (-D).
part = "bracket"; a = 60; b = 40; c = 8; n = 24; r = 5; turn = [0, 0, 0]; move = [0, 0, 0];
$fn = n;

module bracket() difference() {
  union() {
    cube([a, b, c]);
    cube([c, b, 0.8 * a]);
    translate([c, b / 2 - c / 4, c]) rotate([90, 0, 0]) mirror([0, 0, 1])
      linear_extrude(c / 2) polygon([[0, 0], [a / 3, 0], [0, a / 3]]);
  }
  for (y = [0.25, 0.75]) translate([0.75 * a, y * b, -1]) cylinder(r = r, h = c + 2);
  translate([-1, b / 2, 0.6 * a]) rotate([0, 90, 0]) cylinder(r = r, h = c + 2);
}
module tube() difference() { cylinder(r = b / 2, h = a); translate([0, 0, -1]) cylinder(r = b / 2 - r, h = a + 2); }
module gear() difference() {
  union() {
    cylinder(r = b / 2, h = c);
    for (i = [0 : n - 1]) rotate(360 * i / n) translate([b / 2, 0, c / 2]) cube([2 * r, 3.14159 * b / n / 2, c], center = true);
  }
  translate([0, 0, -1]) cylinder(r = b / 8, h = c + 2);
}
module plate() difference() {
  cube([a, b, r / 5]);
  for (i = [1 : 4], j = [1 : 3]) translate([i * a / 5, j * b / 4, -1]) cylinder(r = b / 20, h = r);
}
module rounded() minkowski() { cube([a / 2, b / 2, c]); sphere(r, $fn = 12); }
module vase() rotate_extrude() translate([b / 4, 0]) polygon(concat(
  [for (i = [0 : 20]) [b / 8 * sin(18 * i) + c, a * i / 20]],
  [for (i = [20 : -1 : 0]) [b / 8 * sin(18 * i) + c - r / 2, a * i / 20]]));
module twisted() linear_extrude(a, twist = 120, slices = 20) square([b / 2, c], center = true);
module hull_of() hull() { sphere(b / 4); translate([a, 0, 0]) cube(c, center = true); translate([0, b, c]) cylinder(r = r, h = c); }
module lattice() for (i = [0 : 2], j = [0 : 2]) {
  translate([i * a / 3, j * a / 3, 0]) cube([r, r, a * 2 / 3 + r]);
  translate([i * a / 3, 0, j * a / 3]) cube([r, a * 2 / 3 + r, r]);
  translate([0, i * a / 3, j * a / 3]) cube([a * 2 / 3 + r, r, r]);
}
module clevis() difference() {
  union() { cylinder(r = b / 3, h = a / 2); translate([-b / 3, 0, 0]) cube([2 * b / 3, b, a / 2]); }
  translate([0, 0, -1]) cylinder(r = r, h = a);
  translate([-b, -b, a / 6]) cube([2 * b, 2 * b, a / 6]);
}
module knob() difference() {
  union() { sphere(b / 2); cylinder(r = b / 4, h = a); }
  for (i = [0 : 5]) rotate(60 * i) translate([b / 2, 0, -b]) cylinder(r = r, h = 2 * b);
  translate([0, 0, a - c]) cylinder(r1 = 0, r2 = b / 5, h = c + 1);
}
module cavity() difference() { cube([a, b, a / 2]); translate([a / 2, b / 2, a / 4]) sphere(b / 5); }
module letters() linear_extrude(c) text("Hookeye", size = b / 2, $fn = 6);
module spring_plate() linear_extrude(r / 4) difference() {
  square([a, b]);
  for (i = [0 : 3]) translate([(i + 0.5) * a / 4 - r / 4, i % 2 == 0 ? -1 : c]) square([r / 2, b - c + 1]);
}

translate(move) rotate(turn) {
  if (part == "bracket") bracket();
  else if (part == "tube") tube();
  else if (part == "gear") gear();
  else if (part == "plate") plate();
  else if (part == "rounded") rounded();
  else if (part == "vase") vase();
  else if (part == "twisted") twisted();
  else if (part == "hull") hull_of();
  else if (part == "lattice") lattice();
  else if (part == "clevis") clevis();
  else if (part == "knob") knob();
  else if (part == "cavity") cavity();
  else if (part == "letters") letters();
  else if (part == "spring_plate") spring_plate();
}
