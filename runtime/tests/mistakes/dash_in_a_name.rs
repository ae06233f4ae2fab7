touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = hypot(d, z - 3) - 3;
        region hub-1 where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
