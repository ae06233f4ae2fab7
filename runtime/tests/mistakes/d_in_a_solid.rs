fn main() {
    let _ = Post;
}

touchoff::tool! {
    solid Post "a round post" {
        units mm;
        region post where d <= 3, 0 <= z <= 10 {
            depth: min(3 - hypot(x, y), z, 10 - z);
        }
    }
}
