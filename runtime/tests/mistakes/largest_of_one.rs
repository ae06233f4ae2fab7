touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = max(d) - 3;
        region ball where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
