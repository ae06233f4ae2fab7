touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = hypot(d, z - 3) - 3;
        region ball where nose <= 0 { depth: -nsoe; }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
