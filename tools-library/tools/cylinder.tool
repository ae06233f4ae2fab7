tool Cylinder "finite cylinder, radius 2, height 6, centred on its middle (Ho 1999, fig. 4.2, 4.3)" {
    units mm;
    param r = 2;
    param h = 3; // half the height
    tip z = -h;

    // Each is the distance to one face, positive inside.
    curve side = r - d;
    curve low = h + z;
    curve high = h - z;

    region side where 0 <= side <= min(low, high) { depth: side; }
    region bottom where 0 <= low <= min(side, high) { depth: low; }
    region top where 0 <= high <= min(side, low) { depth: high; }
}
