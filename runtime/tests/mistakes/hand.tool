tool Hand {
    units mm;
    region pin where d <= 1, 0 <= z <= 5 { depth: min(1 - d, min(z, 5 - z)); }
}
