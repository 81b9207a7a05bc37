# Short names for the common commands; `just --list` shows them. Each only calls a script or cargo.

# Everything a change must pass, as CI runs it
check:
    .ci/run

# All tests; arguments go to `cargo test`
test *args:
    scripts/test {{args}}

# Render one scene: just render examples/01_sphere.vol -o out.png
render scene *args:
    cargo run --release -- render {{scene}} {{args}}

# Render every example into a folder
gallery folder="target/gallery":
    mkdir -p {{folder}}
    cargo build --release
    for scene in examples/*.vol; do echo "$scene"; cargo run -q --release -- render "$scene" -o "{{folder}}/$(basename "$scene" .vol).png" || exit 1; done

# Benchmarks; arguments go to `cargo bench`
bench *args:
    cargo bench --workspace {{args}}

# Format all Rust code
fmt:
    cargo fmt --all
