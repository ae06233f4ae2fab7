tool NoSemicolon {
    units mm;
    let r = 3
    profile { start (0, 0); line to (r, 0), (r, 5), (0, 5) as body; }
}
