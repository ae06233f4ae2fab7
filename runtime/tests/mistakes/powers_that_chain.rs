touchoff::tool! {
    tool Ball {
        units mm;
        let r = 2^3^2;
        curve nose = hypot(d, z - r) - r;
        region ball where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
