touchoff::tool! {
    tool Ball {
        units mm;
        region ball where hypot(d, z - 3) <= 3 { direction: (1, 0); }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
