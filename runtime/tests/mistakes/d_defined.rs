touchoff::tool! {
    tool Ball {
        units mm;
        let d = 6;
        region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
