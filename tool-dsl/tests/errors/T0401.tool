tool Ball {
    units mm;
}
