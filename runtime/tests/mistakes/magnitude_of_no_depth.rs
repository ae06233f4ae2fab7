touchoff::tool! {
    tool Ball {
        units mm;
        region ball where hypot(d, z - 3) <= 3 { magnitude: depth^2; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
