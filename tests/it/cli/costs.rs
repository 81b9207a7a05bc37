//! What `vol profile` says, and the pictures of `vol render --aov cost`.

use super::{Sandbox, equal, trial};
use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};
use libtest_mimic::{Failed, Trial};
use serde_json::Value;

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("profile::sums_add_up", sums_add_up),
        trial("profile::the_dear_line_comes_first", dear_line),
        trial("profile::counts_do_not_depend_on_threads", counts_and_threads),
        trial("profile::tables", tables),
        trial("aov_cost::exr", cost_exr),
        trial("aov_cost::png", cost_png),
        trial("aov_cost::counts_are_those_of_the_profile", same_as_profile),
        trial("aov_cost::steps_of_loops_count", loops),
        trial("aov_cost::does_not_depend_on_threads", cost_and_threads),
    ]
}

/// Lines of very different cost.
const NOISY: &str = "\
medium fog {
  region:  sphere(1)
  density: q => 2
    * max(0, fbm(4 * q.local, 8))
    * (1.5 + q.local.x)
  scatter: 1
}
object floor { shape: plane((0, 1, 0), -2), material: diffuse(0.5) }
light sun { from: (1, 1, 1), color: 2 }
render { size: (48, 32), background: #203040 }
";

/// A loop that ends after as many steps as the place says.
const LOOPED: &str = "\
medium fog {
  region:  box((2, 1, 1))
  density: q => {
    let last = iterate 64 from (a = 0) while a < 10 + 10 * q.local.x: (a = a + 1)
    0.01 * last.a
  }
}
render { size: (48, 32), samples: 1 }
";

/// What a profile says as JSON.
struct Rows(Vec<Value>);

impl Rows {
    fn of(sandbox: &Sandbox, arguments: &str) -> Result<Self, Failed> {
        let outcome = sandbox.vol(&format!("profile {arguments} --message-format json"))?.expect(0, &[])?;
        Ok(Self(outcome.stdout.lines().map(serde_json::from_str).collect::<Result<_, _>>()?))
    }

    fn of_kind(&self, kinds: &[&str]) -> impl Iterator<Item = &Value> {
        self.0.iter().filter(move |row| kinds.iter().any(|kind| row["kind"] == *kind))
    }

    fn sum(&self, kinds: &[&str], key: &str) -> f64 {
        self.of_kind(kinds).filter_map(|row| row[key].as_f64()).sum()
    }
}

fn sums_add_up(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("noisy.vol", NOISY)?;
    let rows = Rows::of(sandbox, "noisy.vol --threads 1")?;
    for key in ["milliseconds", "operations", "share"] {
        let total = rows.sum(&["total"], key);
        for parts in [["line", "compiler", "integrator"], ["function", "integrator", ""]] {
            let sum = rows.sum(&parts, key);
            if total <= 0.0 || (sum - total).abs() > 1e-9 * total {
                return Err(format!("{key} of {parts:?}: {sum} of {total}").into());
            }
        }
    }
    equal(rows.sum(&["function"], "evaluations"), rows.sum(&["total"], "evaluations"))?;
    equal(rows.sum(&["integrator"], "operations"), 0.0)
}

fn dear_line(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("noisy.vol", NOISY)?;
    let rows = Rows::of(sandbox, "noisy.vol")?;
    let first = rows.of_kind(&["line"]).next().ok_or("no line")?;
    equal((first["file"].as_str(), first["line"].as_u64()), (Some("noisy.vol"), Some(4)))?;
    equal(first["text"].as_str(), Some("* max(0, fbm(4 * q.local, 8))"))
}

fn counts_and_threads(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("noisy.vol", NOISY)?;
    let counts = |threads: u32| -> Result<Vec<String>, Failed> {
        let rows = Rows::of(sandbox, &format!("noisy.vol --threads {threads}"))?;
        let mut counts: Vec<String> = rows
            .0
            .iter()
            .map(|row| {
                let name = ["kind", "line", "function"].map(|key| row[key].to_string()).join(" ");
                format!("{name} {} {}", row["evaluations"], row["operations"])
            })
            .collect();
        counts.sort();
        Ok(counts)
    };
    equal(counts(3)?, counts(1)?)
}

fn tables(sandbox: &Sandbox) -> Result<(), Failed> {
    let outcome = sandbox.vol("profile fog.vol --size 16x9")?.expect(0, &["16x9", "threads"])?;
    for words in ["fog.vol:1", "(integrator)", "region of fog", "share", "total", "100.0 %"] {
        if !outcome.stdout.contains(words) {
            return Err(format!("`{words}` expected on stdout: {outcome:#?}").into());
        }
    }
    equal(sandbox.new_files()?, Vec::new())
}

/// A channel of a picture.
fn channel(sandbox: &Sandbox, picture: &str, name: &str) -> Result<Vec<f32>, Failed> {
    let image = read().no_deep_data().largest_resolution_level().all_channels();
    let image = image.first_valid_layer().all_attributes().from_file(sandbox.path(picture))?;
    let channels = image.layer_data.channel_data.list;
    let found = channels.into_iter().find(|channel| channel.name.to_string() == name);
    match found.ok_or_else(|| format!("no channel {name}"))?.sample_data {
        FlatSamples::F32(samples) => Ok(samples),
        FlatSamples::F16(_) | FlatSamples::U32(_) => Err("not 32-bit float".into()),
    }
}

fn cost_exr(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox
        .vol("render fog.vol -o a.exr --aov cost --backend auto")?
        .expect(0, &["on CPU", "operations in a"])?;
    sandbox.vol("render fog.vol -o b.exr --backend cpu")?.expect(0, &[])?;
    for name in ["R", "G", "B", "A", "Z", "Transmittance.G", "Error.Estimate"] {
        equal(channel(sandbox, "a.exr", name)?, channel(sandbox, "b.exr", name)?)?;
    }
    for name in ["Cost.Operations", "Cost.Evaluations"] {
        let costs = channel(sandbox, "a.exr", name)?;
        // Dear where the medium is, nothing beside it.
        let (corner, centre) = (costs[0], costs[9 * 32 + 16]);
        if corner != 0.0 || centre < 20.0 {
            return Err(format!("{name}: {corner} in the corner, {centre} in the centre").into());
        }
        if channel(sandbox, "b.exr", name).is_ok() {
            return Err(format!("{name} without being asked").into());
        }
    }
    Ok(())
}

fn cost_png(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.vol("render fog.vol -o a.png --aov cost --backend cpu")?.expect(0, &[])?;
    let picture = image::open(sandbox.path("a.png"))?.to_rgb8();
    equal(picture.get_pixel(0, 0).0, [68, 1, 84])?;
    equal(picture.pixels().filter(|pixel| pixel.0 == [253, 231, 37]).count() > 0, true)
}

fn same_as_profile(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("noisy.vol", NOISY)?;
    for options in ["--samples 1", "--samples 40 --adaptive 0.1"] {
        sandbox.vol(&format!("render noisy.vol -o a.exr --aov cost {options}"))?.expect(0, &[])?;
        let rows = Rows::of(sandbox, &format!("noisy.vol {options}"))?;
        for (name, key) in [("Cost.Operations", "operations"), ("Cost.Evaluations", "evaluations")] {
            let sum: f64 = channel(sandbox, "a.exr", name)?.into_iter().map(f64::from).sum();
            equal(sum, rows.sum(&["total"], key))?;
        }
    }
    Ok(())
}

fn loops(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("looped.vol", LOOPED)?;
    sandbox.vol("render looped.vol -o a.exr --aov cost")?.expect(0, &[])?;
    let [operations, evaluations] =
        ["Cost.Operations", "Cost.Evaluations"].map(|name| channel(sandbox, "a.exr", name));
    let (operations, evaluations) = (operations?, evaluations?);
    let per_point = |column: usize| operations[16 * 48 + column] / evaluations[16 * 48 + column];
    // The camera looks along -z: places on the right take more steps.
    if per_point(32) > 1.5 * per_point(16) {
        return Ok(());
    }
    Err(format!("{} on the left, {} on the right", per_point(16), per_point(32)).into())
}

fn cost_and_threads(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("noisy.vol", NOISY)?;
    for threads in [1, 3] {
        let arguments = format!("render noisy.vol -o {threads}.exr --aov cost --threads {threads}");
        sandbox.vol(&arguments)?.expect(0, &[])?;
    }
    equal(sandbox.read("1.exr")?, sandbox.read("3.exr")?)
}
