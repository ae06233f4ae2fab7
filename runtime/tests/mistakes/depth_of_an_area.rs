touchoff::tool! {
    tool Ball {
        units mm;
        region ball where hypot(d, z - 3) <= 3 { depth: 9 - d^2 - (z - 3)^2; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
