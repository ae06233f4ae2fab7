tool Cone "Kegel, 60°" {
    units mm;
    let slope = tan(30°);
    region cone where slope*d <= z, z <= 5 { depth: min(z - slope*d, 5 - z); }
}
