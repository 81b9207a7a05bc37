//! What holds for any scene, on generated ones: every construct of the grammar in random layouts.

use super::{check, source};
use crate::fmt::{format, is_faithful};

/// A generator of texts; the same for the same seed.
pub(super) struct Generator {
    state: u64,
    tokens: Vec<String>,
    /// How much deeper expressions may still become.
    depth: usize,
}

impl Generator {
    pub(super) fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1, tokens: Vec::new(), depth: 0 }
    }

    pub(super) fn below(&mut self, limit: usize) -> usize {
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) as usize % limit.max(1)
    }

    pub(super) fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }

    fn put(&mut self, tokens: &str) {
        self.tokens.extend(tokens.split(' ').map(str::to_owned));
    }

    fn name(&mut self) {
        let name = self.pick(&[
            "a",
            "q",
            "from",
            "while",
            "iterate_",
            "spine",
            "a_name_of_some_length",
            "sun",
            "x2",
        ]);
        self.put(name);
    }

    /// A file of some items, in a random layout.
    pub(super) fn file(&mut self) -> String {
        let mut text = String::new();
        for _ in 0..1 + self.below(5) {
            self.tokens.clear();
            self.item();
            let tokens = std::mem::take(&mut self.tokens);
            self.lay_out(&tokens, &mut text);
            text += self.pick(&[
                "\n",
                "\n",
                "\r\n",
                " ",
                " // behind\n",
                "\n\n\n\n",
                "\n// between\n\n",
                "\n/// doc\n",
            ]);
        }
        text
    }

    /// Tokens with random gaps; `~` is a line end that the meaning needs.
    fn lay_out(&mut self, tokens: &[String], text: &mut String) {
        let loose = self.below(3);
        for (i, token) in tokens.iter().enumerate() {
            if token == "~" {
                *text += self.pick(&["\n", "\n", "\n\n", " // bound\n  "]);
                continue;
            }
            *text += token;
            let may_end_line = token.len() == 1 && "{[(,+*=:".contains(token.as_str())
                || tokens.get(i + 1).is_some_and(|next| ")]}.,+*".contains(next.as_str()));
            *text += match (may_end_line, self.below(40)) {
                (true, 0) => " // why é\n",
                (true, 1) => "\n  // own line\n",
                (true, 2) => "\n\n\n",
                (true, 3..8) if loose > 0 => "\n\t ",
                (_, 39) if loose > 1 => "\n",
                _ => " ",
            };
        }
    }

    fn item(&mut self) {
        self.depth = 2 + self.below(4);
        match self.below(7) {
            0 => {
                self.put("param");
                self.name();
                self.put(": float =");
                self.expr();
                if self.below(2) == 0 {
                    self.put("in");
                    self.sum();
                    self.put("..");
                    self.sum();
                }
            }
            1 => {
                self.put("let");
                self.name();
                self.put("=");
                self.expr();
            }
            2 => {
                self.put("fn");
                self.name();
                self.separated("(", ")", Self::parameter);
                self.put("-> vec3");
                self.block();
            }
            3 => {
                self.put("import \"lib/clouds.vol\" as");
                self.name();
            }
            _ => {
                let block = self.pick(&["camera", "light", "object", "medium", "render", "style"]);
                self.put(block);
                if self.below(2) == 0 {
                    self.name();
                }
                self.record();
            }
        }
    }

    fn separated(&mut self, open: &str, close: &str, part: fn(&mut Self)) {
        self.put(open);
        let count = self.below(4);
        for i in 0..count {
            part(self);
            if i + 1 < count || self.below(4) == 0 {
                self.put(",");
            }
        }
        self.put(close);
    }

    fn parameter(&mut self) {
        self.name();
        let ty = self.pick(&[": float", ": [ [ vec3 ] ]", ": ( float , vec3 ) -> shape", ": ( ) -> int"]);
        self.put(ty);
        if self.below(3) == 0 {
            self.put("=");
            self.expr();
        }
    }

    fn record(&mut self) {
        self.put("{");
        for _ in 0..self.below(4) {
            self.name();
            self.put(":");
            self.expr();
            let end = self.pick(&[",", "~", ", ~"]);
            self.put(end);
        }
        self.put("}");
    }

    fn block(&mut self) {
        self.put("{");
        for _ in 0..self.below(3) {
            self.put("let");
            self.name();
            self.put("=");
            self.expr();
            self.put("~");
        }
        self.expr();
        self.put("}");
    }

    fn sum(&mut self) {
        let number = self.pick(&["1", ".5", "2e-3", "45deg", "a"]);
        self.put(number);
        if self.below(3) == 0 {
            self.put("- 1");
        }
    }

    fn expr(&mut self) {
        if self.depth == 0 {
            let leaf = self.pick(&[
                "1",
                ".5",
                "2e-3",
                "500ms",
                "#ffF",
                "\"a // b\\\"é\"",
                "true",
                "q",
                "time",
                "- 1.0",
            ]);
            return self.put(leaf);
        }
        self.depth -= 1;
        match self.below(14) {
            0..4 => {
                for _ in 0..1 + self.below(4) {
                    self.operand();
                    let operator = self.pick(&[
                        "+", "-", "*", "/", "%", "|", "&", "||", "&&", "==", "<", ">=", "+", "*", "- -",
                        "* !", "- - -",
                    ]);
                    self.put(operator);
                }
                self.operand();
            }
            4 => {
                self.put("if");
                self.expr();
                self.put("then");
                self.expr();
                self.put("else");
                self.expr();
            }
            5 => {
                let params = self.pick(&["q =>", "( t , l ) =>", "( ) =>"]);
                self.put(params);
                self.expr();
            }
            6 => self.block(),
            7 => self.record(),
            8 => self.iterate(),
            _ => self.operand(),
        }
        self.depth += 1;
    }

    fn iterate(&mut self) {
        self.put("iterate");
        self.expr();
        self.put("from");
        self.states();
        if self.below(2) == 0 {
            self.put("while");
            self.expr();
        }
        self.put(":");
        self.states();
    }

    fn states(&mut self) {
        self.put("(");
        for _ in 0..self.below(3) {
            self.name();
            self.put("=");
            self.expr();
            self.put(",");
        }
        self.put("z =");
        self.expr();
        self.put(")");
    }

    fn operand(&mut self) {
        if self.depth == 0 {
            return self.expr();
        }
        self.depth -= 1;
        match self.below(7) {
            0 => self.separated("[", "]", Self::expr),
            3 => {
                self.put("keys ( time , 0s :");
                self.expr();
                self.put(", 2s + 1 :");
                self.expr();
                self.put(", ease : smooth )");
            }
            4 => {
                self.put("( at :");
                self.expr();
                self.put(", #ff0033 )");
            }
            1 => {
                self.put("[ for i in 0 ..");
                self.sum();
                self.put(":");
                self.expr();
                self.put("]");
            }
            2 => {
                self.put("(");
                for _ in 0..self.below(3) {
                    self.expr();
                    self.put(",");
                }
                self.expr();
                self.put(")");
            }
            _ => self.chain(),
        }
        self.depth += 1;
    }

    fn chain(&mut self) {
        self.name();
        if self.below(2) == 0 {
            self.separated("(", ")", Self::argument);
        }
        for _ in 0..self.below(4) {
            self.put(".");
            self.name();
            if self.below(4) > 0 {
                self.separated("(", ")", Self::argument);
            }
        }
    }

    fn argument(&mut self) {
        if self.below(4) == 0 {
            self.put("smooth :");
        }
        self.expr();
    }
}

#[test]
fn generated_scenes_keep_their_meaning() {
    let mut formatted = 0;
    for seed in 0..1000 {
        let text = Generator::new(seed).file();
        formatted += usize::from(check(&text));
    }
    // The others have a line end where none may be.
    assert!(formatted > 700, "{formatted}");
}

#[test]
fn soups_of_tokens_are_never_damaged() {
    const TOKENS: &[&str] = &[
        "let a =",
        "let",
        "a",
        "b",
        "=",
        "(",
        ")",
        "(",
        ")",
        "{",
        "}",
        "[",
        "]",
        ",",
        ":",
        "+",
        "-",
        "- ",
        "!",
        ".",
        "..",
        "=>",
        "if",
        "then",
        "else",
        "1",
        "#fff",
        "\n",
        "\n",
        " // c\n",
        "object a {",
        "camera {",
        "k: ",
        "\"s\"",
        "for i in",
        "/// d\n",
        "\r",
        "\n\n\n",
        "#vol 1\n",
        "iterate",
        "from",
        "while",
    ];
    let mut generator = Generator::new(11);
    let mut formatted = 0;
    for _ in 0..20_000 {
        let count = 1 + generator.below(12);
        let text: Vec<&str> = (0..count).map(|_| generator.pick(TOKENS)).collect();
        formatted += usize::from(check(&text.join(" ")));
    }
    assert!(formatted > 300, "{formatted}");
}

#[test]
fn planted_changes_are_seen() {
    // What a careless formatter may do to a text.
    let changes = [
        ("// ", "//"),
        (" - ", " + "),
        ("1", "2"),
        (" // why", ""),
        ("///", "//"),
        (":", " : 1 +"),
        ("\n", ""),
        ("q", "r"),
    ];
    let mut seen = 0;
    for seed in 0..200 {
        let text = Generator::new(seed).file();
        let Ok(formatted) = format(&source(&text)) else { continue };
        assert!(is_faithful(&source(&text), &source(&formatted)), "{text}");
        for (from, to) in changes.iter().filter(|(from, _)| formatted.contains(from)) {
            let changed = formatted.replacen(from, to, 1);
            if *from != "\n" || changed.contains("//") {
                seen += usize::from(!is_faithful(&source(&text), &source(&changed)));
            }
        }
    }
    assert!(seen > 300, "{seen}");
}
