tool Mill "10 mm end mill on a 12 mm shank, in a holder" {
    units mm;
    profile {
        start (0, 0);
        line to (5, 0)                        as tip   cutting;
        line to (5, 15)                       as flute cutting;
        line to (6, 18), (6, 35)              as shank;
        line to (20, 35), (20, 70), (0, 70)   as holder;
    }
    niceness cutting: 1;
}
