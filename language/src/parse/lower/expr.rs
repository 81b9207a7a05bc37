//! Expressions and types.
//!
//! The guard bounds how deep these functions recurse; the height of the tree they build, which
//! also grows with every operator of a chain, is counted here and kept within [`MAX_DEPTH`].

use super::{Parts, Rule, Unit, literal};
use crate::ast::{
    Argument, BinaryOp, Entry, Expr, ExprKind, Iterate, Keys, Let, Name, TypeExpr, TypeExprKind, UnaryOp,
};
use crate::diag::Diagnostic;
use crate::parse::{MAX_DEPTH, Report, explain};
use crate::source::Span;
use pest::iterators::Pair;
use pest::pratt_parser::{Assoc, Op, PrattParser};
use std::cell::{Cell, RefCell};
use std::sync::LazyLock;

/// Precedences, loosest first, as `ast::BinaryOp` lists them.
static PRECEDENCE: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    let left = |rule| Op::infix(rule, Assoc::Left);
    PrattParser::new()
        .op(left(Rule::or))
        .op(left(Rule::and))
        .op(left(Rule::equal)
            | left(Rule::not_equal)
            | left(Rule::less)
            | left(Rule::less_equal)
            | left(Rule::greater)
            | left(Rule::greater_equal))
        .op(left(Rule::union))
        .op(left(Rule::intersection))
        .op(left(Rule::add) | left(Rule::subtract))
        .op(left(Rule::multiply) | left(Rule::divide) | left(Rule::modulo))
        .op(Op::prefix(Rule::negate) | Op::prefix(Rule::not))
        .op(Op::postfix(Rule::call) | Op::postfix(Rule::member) | Op::postfix(Rule::lambda_tail))
});

/// The word that begins a key-framed value; its arguments have places instead of names.
const KEYS: &str = "keys";

/// An expression with the height of its tree.
struct Tree {
    expr: Expr,
    height: usize,
}

/// Turns one unit's pairs into nodes.
pub(super) struct Lowerer<'a> {
    /// Where the unit begins in the file.
    offset: usize,
    report: RefCell<&'a mut Report>,
    /// Whether a tree of this unit was already refused as too high.
    refused: Cell<bool>,
}

impl<'a> Lowerer<'a> {
    pub(super) fn new(unit: &Unit<'_>, report: &'a mut Report) -> Self {
        let offset = unit.span().start as usize;
        Self { offset, report: RefCell::new(report), refused: Cell::new(false) }
    }

    pub(super) fn report(&self, diagnostic: Diagnostic) {
        self.report.borrow_mut().add(diagnostic);
    }

    /// The place of a pair without the blanks that pest leaves at its end.
    fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let start = self.offset + pair.as_span().start();
        Span::new(start, start + pair.as_str().trim_end().len())
    }

    pub(super) fn name(&self, pair: &Pair<'_, Rule>) -> Name {
        Name { text: pair.as_str().to_owned(), span: self.span(pair) }
    }

    /// The value of a string and its place.
    pub(super) fn text(&self, pair: &Pair<'_, Rule>) -> (String, Span) {
        let span = self.span(pair);
        match self.checked(literal::string(pair.as_str(), span)) {
            ExprKind::String(text) => (text, span),
            _ => (String::new(), span),
        }
    }

    pub(super) fn type_expr(&self, pair: Pair<'_, Rule>) -> TypeExpr {
        let pair = Parts::of(pair).next();
        let mut span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::list_type => TypeExprKind::List(Box::new(self.type_expr(Parts::of(pair).next()))),
            Rule::function_type => {
                let types = pair.into_inner().filter(|pair| pair.as_rule() == Rule::type_expr);
                let mut types: Vec<TypeExpr> = types.map(|pair| self.type_expr(pair)).collect();
                let result = types.pop().expect("the grammar asks for a result");
                span = span.to(result.span);
                TypeExprKind::Function(types, Box::new(result))
            }
            _ => TypeExprKind::Named(pair.as_str().to_owned()),
        };
        TypeExpr { kind, span }
    }

    pub(super) fn expr(&self, pair: Pair<'_, Rule>) -> Expr {
        self.tree(pair).expr
    }

    pub(super) fn block(&self, pair: Pair<'_, Rule>) -> Expr {
        self.block_tree(pair).expr
    }

    pub(super) fn entry(&self, pair: Pair<'_, Rule>) -> Entry {
        self.entry_tree(pair).0
    }

    /// A node above trees of the given height.
    fn node(&self, kind: ExprKind, span: Span, below: usize) -> Tree {
        if below < MAX_DEPTH {
            return Tree { expr: Expr { kind, span }, height: below + 1 };
        }
        if !self.refused.replace(true) {
            self.report(explain::too_long(span));
        }
        // The unit is lost; a small tree keeps the rest of it small.
        Tree { expr: Expr { kind: ExprKind::Bool(false), span }, height: 1 }
    }

    fn tree(&self, pair: Pair<'_, Rule>) -> Tree {
        PRECEDENCE
            .map_primary(|pair| self.primary(pair))
            .map_prefix(|operator, operand| {
                let span = self.span(&operator).to(operand.expr.span);
                let kind = if operator.as_rule() == Rule::not { UnaryOp::Not } else { UnaryOp::Negate };
                self.node(ExprKind::Unary(kind, Box::new(operand.expr)), span, operand.height)
            })
            .map_postfix(|operand, tail| match tail.as_rule() {
                Rule::lambda_tail => self.lambda(operand.expr, tail),
                Rule::call => self.call(operand, tail),
                _ => self.member(operand, tail),
            })
            .map_infix(|left, operator, right| {
                let span = left.expr.span.to(right.expr.span);
                let height = left.height.max(right.height);
                let operator = binary_op(operator.as_rule());
                let kind = ExprKind::Binary(operator, Box::new(left.expr), Box::new(right.expr));
                self.node(kind, span, height)
            })
            .parse(pair.into_inner())
    }

    fn primary(&self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let text = pair.as_str();
        let kind = match pair.as_rule() {
            Rule::paren => return self.paren(pair),
            Rule::list => return self.list(pair),
            Rule::if_expr => return self.if_expr(pair),
            Rule::record => return self.record(pair),
            Rule::iterate => return self.iterate(pair),
            Rule::block => return self.block_tree(pair),
            Rule::number => self.checked(literal::number(text, span)),
            Rule::color => self.checked(literal::color(text, span)),
            Rule::string => self.checked(literal::string(text, span)),
            Rule::boolean => ExprKind::Bool(text == "true"),
            _ => ExprKind::Name(text.to_owned()),
        };
        self.node(kind, span, 0)
    }

    fn checked(&self, (kind, wrong): (ExprKind, impl IntoIterator<Item = Diagnostic>)) -> ExprKind {
        wrong.into_iter().for_each(|diagnostic| self.report(diagnostic));
        kind
    }

    /// Trees of all expressions among the parts, and the greatest height.
    fn trees<'i>(&self, pairs: impl Iterator<Item = Pair<'i, Rule>>) -> (Vec<Expr>, usize) {
        let mut height = 0;
        let exprs = pairs.map(|pair| {
            let tree = self.tree(pair);
            height = height.max(tree.height);
            tree.expr
        });
        (exprs.collect(), height)
    }

    /// `(a)`, a vector, the parameters of a function, or settings with names.
    fn paren(&self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let (inside, tails): (Vec<_>, Vec<_>) =
            pair.into_inner().partition(|pair| pair.as_rule() == Rule::argument);
        let (arguments, height) = self.arguments(inside.into_iter());
        if arguments.iter().any(|argument| argument.name.is_some()) {
            if let Some(tail) = tails.into_iter().next() {
                self.report(explain::not_a_parameter(span));
                return self.tree(Parts::of(tail).next());
            }
            return self.node(ExprKind::NamedTuple(arguments), span, height);
        }
        let mut exprs: Vec<Expr> = arguments.into_iter().map(|argument| argument.value).collect();
        if let Some(tail) = tails.into_iter().next() {
            return self.lambda(Expr { kind: ExprKind::Tuple(exprs), span }, tail);
        }
        match exprs.len() {
            0 => self.report(explain::empty_brackets(span)),
            1 => {
                let kind = exprs.remove(0).kind;
                return Tree { expr: Expr { kind, span }, height };
            }
            2..=4 => {}
            count => self.report(explain::long_tuple(span, count)),
        }
        self.node(ExprKind::Tuple(exprs), span, height)
    }

    /// `params => body`, where the parameters were read as a name or a vector of names.
    fn lambda(&self, params: Expr, tail: Pair<'_, Rule>) -> Tree {
        let params_span = params.span;
        let params = match params.kind {
            ExprKind::Tuple(params) => params,
            kind => vec![Expr { kind, span: params_span }],
        };
        let mut names = Vec::new();
        for param in params {
            match param.kind {
                ExprKind::Name(text) => names.push(Name { text, span: param.span }),
                _ => self.report(explain::not_a_parameter(param.span)),
            }
        }
        let body = self.tree(Parts::of(tail).next());
        let span = params_span.to(body.expr.span);
        self.node(ExprKind::Lambda(names, Box::new(body.expr)), span, body.height)
    }

    fn call(&self, callee: Tree, call: Pair<'_, Rule>) -> Tree {
        let span = callee.expr.span.to(self.span(&call));
        if matches!(&callee.expr.kind, ExprKind::Name(name) if name == KEYS) {
            return self.keys(None, call, span);
        }
        let (arguments, height) = self.arguments(call.into_inner());
        let kind = ExprKind::Call(Box::new(callee.expr), arguments);
        self.node(kind, span, height.max(callee.height))
    }

    fn member(&self, object: Tree, member: Pair<'_, Rule>) -> Tree {
        let span = object.expr.span.to(self.span(&member));
        let mut parts = Parts::of(member);
        let name = self.name(&parts.next());
        let Some(call) = parts.next_if(Rule::call) else {
            return self.node(ExprKind::Field(Box::new(object.expr), name), span, object.height);
        };
        if name.text == KEYS {
            return self.keys(Some(object), call, span);
        }
        let (arguments, height) = self.arguments(call.into_inner());
        let kind = ExprKind::MethodCall(Box::new(object.expr), name, arguments);
        self.node(kind, span, height.max(object.height))
    }

    fn arguments<'i>(&self, pairs: impl Iterator<Item = Pair<'i, Rule>>) -> (Vec<Argument>, usize) {
        let mut height = 0;
        let arguments = pairs.map(|pair| {
            let (before, value, below) = self.argument(pair);
            height = height.max(below);
            let name = before.and_then(|before| match before.kind {
                ExprKind::Name(text) => Some(Name { text, span: before.span }),
                _ => {
                    self.report(explain::not_an_argument_name(before.span));
                    None
                }
            });
            Argument { name, value }
        });
        (arguments.collect(), height)
    }

    /// What stands before the colon if there is one, the value, and the greater height.
    fn argument(&self, pair: Pair<'_, Rule>) -> (Option<Expr>, Expr, usize) {
        let mut parts = Parts::of(pair);
        let first = self.tree(parts.next());
        if !parts.has(Rule::expr) {
            return (None, first.expr, first.height);
        }
        let value = self.tree(parts.next());
        (Some(first.expr), value.expr, first.height.max(value.height))
    }

    /// `keys(at, place: value, …, ease: word)`; as a method the receiver is what runs along the keys.
    fn keys(&self, receiver: Option<Tree>, call: Pair<'_, Rule>, span: Span) -> Tree {
        let call_span = self.span(&call);
        let mut height = receiver.as_ref().map_or(0, |receiver| receiver.height);
        let mut at = receiver.map(|receiver| receiver.expr);
        let mut keys = Vec::new();
        let mut ease = None;
        for pair in call.into_inner() {
            let (before, value, below) = self.argument(pair);
            height = height.max(below);
            match before {
                Some(before) if matches!(&before.kind, ExprKind::Name(name) if name == "ease") => {
                    ease = Some(value);
                }
                Some(place) => keys.push((place, value)),
                None if at.is_none() => at = Some(value),
                None => {
                    self.report(explain::not_a_key(value.span));
                    break;
                }
            }
        }
        let at = at.unwrap_or_else(|| {
            self.report(explain::empty_keys(call_span));
            Expr { kind: ExprKind::Int(0), span: call_span }
        });
        self.node(ExprKind::Keys(Box::new(Keys { at, keys, ease })), span, height)
    }

    fn iterate(&self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        parts.next_if(Rule::kw_iterate);
        let count = self.tree(parts.next());
        parts.next_if(Rule::kw_from);
        let (state, state_height) = self.states(parts.next());
        let condition = parts.next_if(Rule::kw_while).map(|_| self.tree(parts.next()));
        parts.next_if(Rule::colon);
        let (next, next_height) = self.states(parts.next());
        let condition_height = condition.as_ref().map_or(0, |condition| condition.height);
        let height = count.height.max(state_height).max(next_height).max(condition_height);
        let condition = condition.map(|condition| condition.expr);
        let iterate = Iterate { count: count.expr, state, condition, next };
        self.node(ExprKind::Iterate(Box::new(iterate)), span, height)
    }

    /// `(z = …, dr = …)`
    fn states(&self, pair: Pair<'_, Rule>) -> (Vec<Let>, usize) {
        let mut height = 0;
        let states = pair.into_inner().map(|pair| {
            let mut parts = Parts::of(pair);
            let name = self.name(&parts.next());
            parts.next_if(Rule::equals);
            let value = self.tree(parts.next());
            height = height.max(value.height);
            Let { name, value: value.expr }
        });
        (states.collect(), height)
    }

    fn list(&self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        if let Some(comprehension) = parts.next_if(Rule::comprehension) {
            return self.comprehension(comprehension, span);
        }
        let (exprs, height) = self.trees(parts.pairs);
        self.node(ExprKind::List(exprs), span, height)
    }

    fn comprehension(&self, pair: Pair<'_, Rule>, span: Span) -> Tree {
        let mut parts = Parts::of(pair);
        parts.next_if(Rule::kw_for);
        let variable = self.name(&parts.next());
        parts.next_if(Rule::kw_in);
        let mut range = self.tree(parts.next());
        if parts.next_if(Rule::range_to).is_some() {
            let high = self.tree(parts.next());
            let whole = range.expr.span.to(high.expr.span);
            let height = range.height.max(high.height);
            range = self.node(ExprKind::Range(Box::new(range.expr), Box::new(high.expr)), whole, height);
        }
        parts.next_if(Rule::colon);
        let body = self.tree(parts.next());
        let height = range.height.max(body.height);
        let (range, body) = (Box::new(range.expr), Box::new(body.expr));
        self.node(ExprKind::Comprehension { variable, range, body }, span, height)
    }

    fn if_expr(&self, pair: Pair<'_, Rule>) -> Tree {
        let start = self.span(&pair);
        let parts = pair.into_inner().filter(|pair| pair.as_rule() == Rule::expr);
        let (exprs, height) = self.trees(parts);
        let [condition, yes, no] =
            <[Expr; 3]>::try_from(exprs).expect("the grammar asks for a condition and two branches");
        let span = Span { end: no.span.end, ..start };
        self.node(ExprKind::If(Box::new(condition), Box::new(yes), Box::new(no)), span, height)
    }

    fn entry_tree(&self, pair: Pair<'_, Rule>) -> (Entry, usize) {
        let mut parts = Parts::of(pair);
        let key = self.name(&parts.next());
        parts.next_if(Rule::colon);
        let value = self.tree(parts.next());
        (Entry { key, value: value.expr }, value.height)
    }

    fn record(&self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let (text, start) = (pair.as_str(), span.start);
        let mut height = 0;
        let mut entries: Vec<Entry> = Vec::new();
        for pair in pair.into_inner() {
            let (entry, below) = self.entry_tree(pair);
            if let Some(last) = entries.last() {
                let gap = (last.value.span.end - start) as usize..(entry.key.span.start - start) as usize;
                if !text[gap].contains([',', '\n']) {
                    self.report(explain::missing_comma(entry.key.span, last.value.span.end));
                }
            }
            height = height.max(below);
            entries.push(entry);
        }
        self.node(ExprKind::Record(entries), span, height)
    }

    fn block_tree(&self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let mut height = 0;
        let mut bindings = Vec::new();
        while let Some(binding) = parts.next_if(Rule::binding) {
            let mut parts = Parts::of(binding);
            parts.next_if(Rule::kw_let);
            let name = self.name(&parts.next());
            parts.next_if(Rule::equals);
            let value = self.tree(parts.next());
            height = height.max(value.height);
            bindings.push(Let { name, value: value.expr });
        }
        let value = self.tree(parts.next());
        self.node(ExprKind::Block(bindings, Box::new(value.expr)), span, height.max(value.height))
    }
}

fn binary_op(rule: Rule) -> BinaryOp {
    match rule {
        Rule::or => BinaryOp::Or,
        Rule::and => BinaryOp::And,
        Rule::equal => BinaryOp::Equal,
        Rule::not_equal => BinaryOp::NotEqual,
        Rule::less => BinaryOp::Less,
        Rule::less_equal => BinaryOp::LessEqual,
        Rule::greater => BinaryOp::Greater,
        Rule::greater_equal => BinaryOp::GreaterEqual,
        Rule::union => BinaryOp::Union,
        Rule::intersection => BinaryOp::Intersection,
        Rule::subtract => BinaryOp::Subtract,
        Rule::multiply => BinaryOp::Multiply,
        Rule::divide => BinaryOp::Divide,
        Rule::modulo => BinaryOp::Modulo,
        // The grammar has no other infix operator than `+`.
        _ => BinaryOp::Add,
    }
}
