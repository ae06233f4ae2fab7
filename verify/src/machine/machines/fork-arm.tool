tool ForkArm "arm of a fork head about its pivot: a disc of 220 mm, 70 mm thick" {
    units mm;

    profile {
        start (0, 0);
        line to (110, 0), (110, 70), (0, 70) as arm;
    }
}
