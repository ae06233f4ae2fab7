tool Rod {
    units mm;
    region rod where d <= 3, 0 <= z <= 20 { depth: (3 - d)*z*(20 - z)/(100 + d*z); }
}
