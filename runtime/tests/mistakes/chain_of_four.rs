touchoff::tool! {
    tool Ball {
        units mm;
        region ball where 0 <= z <= 3 <= 5 { depth: z; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
