tool Stepped "a face of two surfaces" {
    units mm;
    profile {
        start (0, 0);
        line to (2, 0)          as bore;
        line to (5, 0)          as rim;
        line to (5, 9), (0, 9)  as body;
    }
}
