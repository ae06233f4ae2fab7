touchoff::tool! {
    tool Ball {
        units mm;
        let hub_1 = 3;
        curve nose = hypot(d, z - hub-1) - hub_1;
        region ball where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
