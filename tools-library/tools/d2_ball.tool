tool D2Ball "2 mm ball end mill, flute to 5, straight shank to 40" {
    units mm;
    let r = 2/2;

    curve nose = hypot(d, z - r) - r;
    curve side = r - d;
    curve end = 40 - z;

    region ball as ball cutting where z <= r, nose <= 0 {
        depth: -nose;
        direction: away from (0, r);
    }
    region flute as flute cutting where r <= z <= 5, side >= 0 {
        depth: side;
        direction: (1, 0);
    }
    region shank where z >= 5, 0 <= side <= end {
        depth: side;
        direction: (1, 0);
    }
    region end as shank where 0 <= end <= side {
        depth: end;
        direction: (0, 1);
    }
    niceness cutting: 1 - depth/r;
}
