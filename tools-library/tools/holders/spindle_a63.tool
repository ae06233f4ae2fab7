tool SpindleA63 "spindle nose for HSK-A63 and the head behind it" {
    units mm;

    profile {
        start (0, 0);
        line to (45, 0), (50, 5), (50, 40), (58, 58), (62, 62), (62, 110), (75, 130), (75, 200)
            as head;
        line to (0, 200) as head;
    }
}
