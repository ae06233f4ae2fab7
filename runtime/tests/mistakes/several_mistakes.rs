touchoff::tool! {
    tool Ball {
        units mm;
        let r = tan(30);
        let s = 3in;
        curve nose = hypot(d, z - 3) + d^2;
        region ball where nsoe <= 0, z < 3 { depth: 3 - d; }
        region core where z <= shnak { depth: 3deg; magnitude: dept; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
