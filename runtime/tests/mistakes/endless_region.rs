touchoff::tool! {
    tool Rod {
        units mm;
        region rod where d <= 3, z >= 0 { depth: min(3 - d, z); }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Rod;
}
