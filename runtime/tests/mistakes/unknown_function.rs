touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = sqr(d^2 + (z - 3)^2) - 3;
        region ball where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
