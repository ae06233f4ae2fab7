touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = hypot(d, z - 3) - 3;
        region ball where nose <= 0 and z <= 3 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
