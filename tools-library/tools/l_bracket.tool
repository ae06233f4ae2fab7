// A solid without an axis: coordinates are x, y and z, and its own frame is the pose's. Regions
// are those of the nearest face, so that the depth is the true distance everywhere inside.
solid LBracket "L-bracket, legs of 30 and 24 mm, 20 mm wide, 6 mm thick, with a hole for an M6 screw" {
    units mm;
    let t = 6; // thickness of both legs
    let w = 20; // width, along y
    let r = 6.6mm/2; // of the hole through the lying leg

    // Each is the distance to one face, positive inside.
    curve bottom = z;
    curve ledge = t - z; // top of the lying leg
    curve end = 20 - x; // its end
    curve bore = hypot(x - 10, y) - r;
    curve side = w/2 - abs(y); // both sides
    curve back = x + 10; // of the standing leg
    curve wall = t - 10 - x; // its inner face
    curve top = 24 - z;
    curve edge = hypot(wall, ledge); // the inner edge, where wall and ledge meet

    // The lying leg, up to the inner edge.
    region lying_bottom as bottom where wall <= 0, 0 <= bottom <= min(ledge, end, side, bore) {
        depth: bottom;
    }
    region lying_top as inner where wall <= 0, 0 <= ledge <= min(bottom, end, side, bore) {
        depth: ledge;
    }
    region lying_end as end where wall <= 0, 0 <= end <= min(bottom, ledge, side) { depth: end; }
    region lying_side as side where wall <= 0, 0 <= side <= min(bottom, ledge, end) { depth: side; }
    region bore where wall <= 0, 0 <= bore <= min(bottom, ledge) {
        depth: bore;
        direction: (10 - x, -y, 0); // to the hole's axis
    }

    // The heel, below and behind the inner edge: from there the edge is the nearest of the inner faces.
    region heel_bottom as bottom where wall >= 0, ledge >= 0, 0 <= bottom <= min(back, side, edge) {
        depth: bottom;
    }
    region heel_back as back where wall >= 0, ledge >= 0, 0 <= back <= min(bottom, side, edge) {
        depth: back;
    }
    region heel_side as side where wall >= 0, ledge >= 0, 0 <= side <= min(bottom, back, edge) {
        depth: side;
    }
    region heel_edge as inner where wall >= 0, ledge >= 0, edge <= min(bottom, back, side) {
        depth: edge;
    }

    // The standing leg, from the inner edge up.
    region standing_back as back where ledge <= 0, 0 <= back <= min(wall, side, top) {
        depth: back;
    }
    region standing_inner as inner where ledge <= 0, 0 <= wall <= min(back, side, top) {
        depth: wall;
    }
    region standing_side as side where ledge <= 0, 0 <= side <= min(back, wall, top) {
        depth: side;
    }
    region standing_top as top where ledge <= 0, 0 <= top <= min(back, wall, side) { depth: top; }
}
