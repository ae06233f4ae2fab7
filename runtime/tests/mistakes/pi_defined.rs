touchoff::tool! {
    tool Ball {
        units mm;
        let pi = 3;
        region ball where d <= 0 { depth: -d; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
