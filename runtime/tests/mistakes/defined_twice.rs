touchoff::tool! {
    tool Ball {
        units mm;
        let r = 3;
        let r = 4;
        curve nose = hypot(d, z - r) - r;
        region ball where nose <= 0 { depth: -nose; }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
