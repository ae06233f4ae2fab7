tol Ball {
    units mm;
}
