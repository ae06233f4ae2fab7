tool OpenPin {
    units mm;
    profile { start (0, 0); line to (1, 0), (1, 10) as pin; }
}
