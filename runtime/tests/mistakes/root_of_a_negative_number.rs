touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = hypot(d, z - 3) - 3;
        region ball where nose <= 0 { depth: -nose; magnitude: sqrt(d - 1); }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
