solid Plate "no outline, so nothing to mount" {
    units mm;
    region plate where -9 <= x <= 9, -9 <= y <= 9, 0 <= z <= 2 { depth: min(9 - abs(x), 9 - abs(y), z, 2 - z); }
}
