touchoff::tool! {
    tool Ball {
        let r = 3;
        units mm;
        region ball where hypot(d, z - r) <= r { depth: r - hypot(d, z - r); }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
