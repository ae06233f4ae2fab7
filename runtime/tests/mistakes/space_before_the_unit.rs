touchoff::tool! {
    tool Ball {
        units mm;
        let r = 3 mm;
        curve nose = hypot(d, z - r) - r;
        region ball where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
