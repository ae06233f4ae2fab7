touchoff::tool! {
    tool Ball {
        units mm;
        curve nose = d + d^2 - z;
        region ball where nose <= 0, z <= 5 { depth: -nose; }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
