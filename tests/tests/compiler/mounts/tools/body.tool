tool Body "a holder's body" {
    units inch;
    param wide = 1;
    profile {
        start (0, 0);
        line to (wide, 0), (wide, 2), (0, 2)  as body;
    }
}
