tool Ball "a ball of 3 mm radius on a straight shank" {
    units mm;
    let r = 3;

    curve nose = hypot(d, z - r) - r;
    curve side = r - d;
    curve end = 30 - z;

    region ball as ball cutting where z <= r, nose <= 0 { depth: -nose; }
    region shank where z >= r, 0 <= side <= end { depth: side; }
    region end as shank where 0 <= end <= side { depth: end; }

    niceness cutting: 1 - depth/r;
}
