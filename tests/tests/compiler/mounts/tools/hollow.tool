tool Hollow "its edge hangs below the face" {
    units mm;
    tip z = -1;
    profile { start (0, 0); line to (4, 0), (5, -1), (6, 0), (6, 5), (0, 5) as body; }
}
