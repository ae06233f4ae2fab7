touchoff::tool! {
    tool Bowl {
        units mm;
        region bowl where d^2 <= z, z <= 5 { depth: 5 - z; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Bowl;
}
