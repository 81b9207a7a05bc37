//! Vector instructions: which ones loops over points are compiled for, chosen when the program runs.
//!
//! A loop that is written for one point after the other is compiled several times, for every set of
//! instructions in [`Isa::all`]; [`Isa::run`] calls the right one. All compute the same bits: lanes are independent and
//! nothing is fused or reordered (test `all_instruction_sets_compute_the_same`).

#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use pulp::{NullaryFnOnce, Scalar128b, Simd, WithSimd};

/// A set of vector instructions that this machine has.
#[derive(Clone, Copy, Debug)]
pub struct Isa(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// What every machine of this kind has.
    Baseline,
    /// AVX2: 8 numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    /// AVX-512: 16 numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
}

impl Isa {
    /// What every machine of this kind has: on x86-64 SSE2 with 4 numbers at a time.
    pub const BASELINE: Self = Self(Kind::Baseline);

    /// The widest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = V4::try_new() {
            return Self(Kind::Avx512(simd));
        } else if let Some(simd) = V3::try_new() {
            return Self(Kind::Avx2(simd));
        }
        Self::BASELINE
    }

    /// All that this machine has, the widest last.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::BASELINE];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(V3::try_new().map(|simd| Self(Kind::Avx2(simd))));
            all.extend(V4::try_new().map(|simd| Self(Kind::Avx512(simd))));
        }
        all
    }

    /// `baseline`, `avx2` or `avx512`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(_) => "avx512",
        }
    }

    /// AVX-512, if that is the set: for loops that are written for its instructions alone.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(crate) fn avx512(self) -> Option<V4> {
        if let Kind::Avx512(simd) = self.0 { Some(simd) } else { None }
    }

    /// Calls a loop compiled for these instructions.
    #[inline(always)]
    pub(crate) fn run<K: Kernel>(self, args: K::Args<'_>) -> K::Out {
        match self.0 {
            Kind::Baseline => K::run(args),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(simd) => simd.vectorize(Call::<K>(args)),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(simd) => simd.vectorize(Call::<K>(args)),
        }
    }

    /// Calls a loop over numbers of any kind compiled for these instructions.
    #[inline(always)]
    pub(crate) fn run_loop<L: Loop>(self, numbers: L) -> L::Out {
        match self.0 {
            Kind::Baseline => numbers.run(),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(simd) => simd.vectorize(LoopCall(numbers)),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(simd) => simd.vectorize(LoopCall(numbers)),
        }
    }

    /// Calls a loop that is written for vectors of these instructions.
    #[inline(always)]
    pub(crate) fn run_vectors<K: VectorKernel>(self, args: K::Args<'_>) -> K::Out {
        match self.0 {
            Kind::Baseline => Simd::vectorize(Scalar128b, VectorCall::<K>(args)),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(simd) => Simd::vectorize(simd, VectorCall::<K>(args)),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(simd) => Simd::vectorize(simd, VectorCall::<K>(args)),
        }
    }
}

/// A loop that is written for vectors, where the compiler does not make them by itself.
pub(crate) trait VectorKernel {
    /// What it reads and writes.
    type Args<'a>;
    /// What it returns.
    type Out;

    /// The loop; inlined by force like [`Kernel::run`].
    fn run<S: Simd>(simd: S, args: Self::Args<'_>) -> Self::Out;
}

/// Such a loop with its arguments, as `pulp` wants it.
struct VectorCall<'a, K: VectorKernel>(K::Args<'a>);

impl<K: VectorKernel> WithSimd for VectorCall<'_, K> {
    type Output = K::Out;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> K::Out {
        K::run(simd, self.0)
    }
}

/// A loop over points; see [`kernel`].
pub(crate) trait Kernel {
    /// What it reads and writes.
    type Args<'a>;
    /// What it returns.
    type Out;

    /// The loop. Inlined by force, and so must be everything that it calls: what is not keeps the instructions
    /// of the baseline.
    fn run(args: Self::Args<'_>) -> Self::Out;
}

/// A kernel with its arguments, as `pulp` wants it.
struct Call<'a, K: Kernel>(K::Args<'a>);

impl<K: Kernel> NullaryFnOnce for Call<'_, K> {
    type Output = K::Out;

    #[inline(always)]
    fn call(self) -> K::Out {
        K::run(self.0)
    }
}

/// A loop over rows of numbers that is written once for f32 and f64, to be called by
/// [`Real::vectorized`](crate::real::Real::vectorized); its fields are what it reads and writes.
pub(crate) trait Loop {
    /// What it returns.
    type Out;

    /// The loop; inlined by force like [`Kernel::run`].
    fn run(self) -> Self::Out;
}

/// Such a loop, as `pulp` wants it.
struct LoopCall<L>(L);

impl<L: Loop> NullaryFnOnce for LoopCall<L> {
    type Output = L::Out;

    #[inline(always)]
    fn call(self) -> L::Out {
        self.0.run()
    }
}

/// Defines a [`Kernel`]: written as a function of one tuple whose references live for the named lifetime, to be
/// called by [`Isa::run`] with the name as the type.
macro_rules! kernel {
    ($(#[$meta:meta])* $vis:vis fn $name:ident<$life:lifetime>($args:tt: $type:ty) $(-> $out:ty)? $body:block) => {
        $(#[$meta])*
        $vis struct $name;

        impl $crate::isa::Kernel for $name {
            type Args<$life> = $type;
            type Out = $crate::isa::kernel!(@out $($out)?);

            #[inline(always)]
            fn run($args: Self::Args<'_>) -> Self::Out $body
        }
    };
    (@out) => { () };
    (@out $out:ty) => { $out };
}
pub(crate) use kernel;
