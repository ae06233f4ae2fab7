// A solid without an axis: coordinates are x, y and z, and its own frame is the pose's.
solid Block "rectangular block, 40 x 30 x 20 mm, standing on the middle of its underside" {
    units mm;
    param w = 40; // along x
    param l = 30; // along y
    param h = 20;

    // Each is the distance to one face, positive inside.
    curve left = x + w/2;
    curve right = w/2 - x;
    curve front = y + l/2;
    curve back = l/2 - y;
    curve bottom = z;
    curve top = h - z;

    // The nearest face, whatever the three sides are.
    region left where 0 <= left <= min(right, front, back, bottom, top) { depth: left; }
    region right where 0 <= right <= min(left, front, back, bottom, top) { depth: right; }
    region front where 0 <= front <= min(left, right, back, bottom, top) { depth: front; }
    region back where 0 <= back <= min(left, right, front, bottom, top) { depth: back; }
    region bottom where 0 <= bottom <= min(left, right, front, back, top) { depth: bottom; }
    region top where 0 <= top <= min(left, right, front, back, bottom) { depth: top; }
}
