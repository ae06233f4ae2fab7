fn main() {
    let _ = Post;
}

touchoff::tool! {
    solid Post "a round post" {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 10), (0, 10) as post;
        }
    }
}
