tool Pin {
    units mm; // Fräser
}
