//! Expressions to compile-time values.

use super::value::{Closure, LocalPoint, Value, Word};
use super::{Lowered, Lowerer, MAX_DEPTH, MAX_UNROLLED};
use crate::ir::graph::Rate;
use crate::ir::{Inst, ValueId};
use crate::ops::Op;
use std::rc::Rc;
use vol_language::ast::{BinaryOp, UnaryOp};
use vol_language::diag::Diagnostic;
use vol_language::hir::{Conversion, ExprId, ExprKind, LocalField, LocalId, Over};
use vol_language::module::ModuleId;
use vol_language::source::Span;

impl Lowerer<'_> {
    /// The value of an expression.
    pub(crate) fn expr(&mut self, id: ExprId) -> Lowered<Value> {
        let span = self.hir.expr(id).span;
        self.unrolled += 1;
        if self.unrolled > MAX_UNROLLED {
            return Err(too_long(span));
        }
        if self.depth >= MAX_DEPTH {
            return Err(too_deep(span));
        }
        self.depth += 1;
        let outer = self.enter(span);
        let value = self.expr_unguarded(id);
        self.graph.set_place(outer);
        self.depth -= 1;
        value
    }

    /// Says that new values are made for an expression; returns what they were made for before. Of the
    /// standard library the author sees the call.
    fn enter(&mut self, span: Span) -> Option<Span> {
        let outer = self.graph.set_place(None);
        let is_own = span.start < vol_language::standard::START;
        self.graph.set_place(if is_own { Some(span) } else { outer });
        outer
    }

    fn expr_unguarded(&mut self, id: ExprId) -> Lowered<Value> {
        let hir = self.hir;
        let expr = hir.expr(id);
        Ok(match &expr.kind {
            ExprKind::Bool(truth) => Value::Numbers(vec![self.graph.boolean(*truth)]),
            ExprKind::Number(number) => self.number(*number),
            ExprKind::Color(rgb) => Value::Numbers(rgb.map(|c| self.graph.number(c)).to_vec()),
            ExprKind::String(text) => Value::String(text.as_str().into()),
            ExprKind::Local(local) => {
                self.environment.get(*local).expect("the checker resolves bindings in scope").clone()
            }
            ExprKind::Let(id) => return self.let_value(id.index()),
            ExprKind::Param(id) => self.param(id.index()),
            ExprKind::Time => Value::Numbers(vec![self.graph.frame_input(0)]),
            ExprKind::Frame => Value::Numbers(vec![self.graph.frame_input(1)]),
            ExprKind::Vector(parts) => self.vector(parts)?,
            ExprKind::Swizzle(base, indices) => {
                let base = self.expr(*base)?;
                Value::Numbers(indices.iter().map(|&i| base.numbers()[usize::from(i)]).collect())
            }
            ExprKind::LocalField(base, field) => match self.expr(*base)? {
                Value::Local(point) => self.local_field(&point, *field, expr.span)?,
                other => unreachable!("the checker gives a local point, not {other:?}"),
            },
            ExprKind::Unary(op, operand) => {
                let operand = self.expr(*operand)?;
                self.unary(*op, &operand)
            }
            ExprKind::Binary(..) => self.binary_chain(id)?,
            ExprKind::If(condition, then, otherwise) => self.choice(*condition, *then, *otherwise)?,
            ExprKind::Block(bindings, body) => {
                for &(local, value) in bindings {
                    let value = self.expr(value)?;
                    self.environment.bind(local, value);
                }
                self.expr(*body)?
            }
            ExprKind::Lambda(params, body) => Value::Function(Rc::new(Closure::Lambda {
                params: params.clone(),
                body: *body,
                captured: self.environment.clone(),
            })),
            ExprKind::CallFunction(function, args) => {
                let args = self.all(args)?;
                self.user_function(function.index(), args, expr.span)?
            }
            ExprKind::CallBuiltin(builtin, args) => {
                let values = self.all(args)?;
                let outer = std::mem::replace(&mut self.arguments, args);
                let value = crate::library::lower(self, *builtin, expr.span, &values);
                self.arguments = outer;
                value?
            }
            ExprKind::CallValue(callee, args) => {
                let callee = self.expr(*callee)?.function();
                let args = self.all(args)?;
                self.call(&callee, &args)?
            }
            ExprKind::List(items) => Value::List(self.all(items)?.into()),
            ExprKind::Comprehension { variable, over, body } => self.comprehension(*variable, over, *body)?,
            ExprKind::Convert(conversion, operand) => {
                let operand = self.expr(*operand)?;
                convert(*conversion, operand, expr.ty.components().unwrap_or(1))
            }
            ExprKind::Keys(keys) => self.keys(keys)?,
            ExprKind::Iterate(iterate) => self.iterate(iterate, expr.span)?,
            ExprKind::RecordField(base, field) => match self.expr(*base)? {
                Value::Record(fields) => fields[*field as usize].clone(),
                other => unreachable!("the checker gives a record, not {other:?}"),
            },
            ExprKind::Choice(word, arguments) if arguments.is_empty() => Value::String((*word).into()),
            ExprKind::Choice(name, arguments) => {
                let arguments = self.placed(arguments)?;
                Value::Word(Rc::new(Word { name, arguments, span: expr.span }))
            }
            ExprKind::BlockName(name) => Value::String(name.as_str().into()),
            ExprKind::Settings(entries) => {
                let value =
                    |&(key, id): &(&'static str, ExprId)| Ok((key, self.expr(id)?, hir.expr(id).span));
                Value::Settings(entries.iter().map(value).collect::<Lowered<_>>()?)
            }
            ExprKind::Error => unreachable!("a scene with errors is not lowered"),
        })
    }

    fn all(&mut self, ids: &[ExprId]) -> Lowered<Vec<Value>> {
        ids.iter().map(|&id| self.expr(id)).collect()
    }

    /// Values with their places, as far as they are given.
    fn placed(&mut self, ids: &[Option<ExprId>]) -> Lowered<Vec<Option<(Value, Span)>>> {
        let value = |id: &Option<ExprId>| match id {
            Some(id) => Ok(Some((self.expr(*id)?, self.hir.expr(*id).span))),
            None => Ok(None),
        };
        ids.iter().map(value).collect()
    }

    fn number(&mut self, number: f64) -> Value {
        Value::Numbers(vec![self.graph.number(number)])
    }

    /// The value of a top-level `let`, or its message, computed once.
    pub(crate) fn let_value(&mut self, index: usize) -> Lowered<Value> {
        if let Some(known) = &self.lets[index] {
            return known.clone();
        }
        // Whatever loop asks for it, it does not depend on that loop.
        let outer_steps = std::mem::replace(&mut self.loop_steps, 1);
        let value = self.expr(self.hir.lets[index].value);
        self.loop_steps = outer_steps;
        self.lets[index] = Some(value.clone());
        value
    }

    fn param(&mut self, index: usize) -> Value {
        let param = &self.hir.params[index];
        let first = self.param_inputs[index];
        let mut components: Vec<ValueId> =
            (0..param.default.len() as u32).map(|i| self.graph.frame_input(first + i)).collect();
        if param.ty == vol_language::ty::Type::Bool {
            let zero = self.graph.number(0.0);
            let off = self.graph.apply(Op::Equal, &[components[0], zero]);
            components[0] = self.graph.apply(Op::Not, &[off]);
        }
        Value::Numbers(components)
    }

    fn vector(&mut self, parts: &[ExprId]) -> Lowered<Value> {
        let mut components = Vec::with_capacity(4);
        for &part in parts {
            components.extend_from_slice(self.expr(part)?.numbers());
        }
        Ok(Value::Numbers(components))
    }

    fn unary(&mut self, op: UnaryOp, operand: &Value) -> Value {
        let op = match op {
            UnaryOp::Negate => Op::Neg,
            UnaryOp::Not => Op::Not,
        };
        let components = operand.numbers().iter().map(|&v| self.graph.apply(op, &[v]));
        Value::Numbers(components.collect())
    }

    /// An operator and the chain of operators on its left, without recursion: sums of thousands of
    /// terms are one long left spine.
    fn binary_chain(&mut self, id: ExprId) -> Lowered<Value> {
        let hir = self.hir;
        let mut spine = Vec::new();
        let mut left = id;
        while let ExprKind::Binary(op, a, b) = &hir.expr(left).kind {
            spine.push((*op, *b, hir.expr(left).span));
            left = *a;
        }
        let span = hir.expr(id).span;
        let mut value = self.expr(left)?;
        for (op, right, place) in spine.into_iter().rev() {
            let right = self.expr(right)?;
            // An operator stands for its own operands, not for all of the chain.
            let outer = self.enter(place);
            value = self.binary(op, &value, &right, span)?;
            self.graph.set_place(outer);
        }
        Ok(value)
    }

    fn binary(&mut self, op: BinaryOp, a: &Value, b: &Value, span: Span) -> Lowered<Value> {
        if let (Value::Shape(a), Value::Shape(b)) = (a, b) {
            return super::shape::operator(self, op, Rc::clone(a), Rc::clone(b), span);
        }
        let (a, b) = (a.numbers(), b.numbers());
        Ok(Value::Numbers(a.iter().zip(b).map(|(&a, &b)| self.scalar_operator(op, a, b)).collect()))
    }

    fn scalar_operator(&mut self, op: BinaryOp, a: ValueId, b: ValueId) -> ValueId {
        let graph = &mut self.graph;
        match op {
            BinaryOp::Or => graph.apply(Op::Or, &[a, b]),
            BinaryOp::And => graph.apply(Op::And, &[a, b]),
            BinaryOp::Equal => equal(graph, a, b),
            BinaryOp::NotEqual => {
                let same = equal(graph, a, b);
                graph.apply(Op::Not, &[same])
            }
            BinaryOp::Less => graph.apply(Op::Less, &[a, b]),
            BinaryOp::LessEqual => graph.apply(Op::LessEqual, &[a, b]),
            BinaryOp::Greater => graph.apply(Op::Less, &[b, a]),
            BinaryOp::GreaterEqual => graph.apply(Op::LessEqual, &[b, a]),
            BinaryOp::Add => graph.add(a, b),
            BinaryOp::Subtract => graph.sub(a, b),
            BinaryOp::Multiply => graph.mul(a, b),
            BinaryOp::Divide => graph.div(a, b),
            BinaryOp::Modulo => crate::library::math::modulo(graph, &[a, b]),
            BinaryOp::Union | BinaryOp::Intersection => unreachable!("only shapes have | and &"),
        }
    }

    fn choice(&mut self, condition: ExprId, then: ExprId, otherwise: ExprId) -> Lowered<Value> {
        let span = self.hir.expr(condition).span;
        let condition = self.expr(condition)?.scalar();
        if let Some(truth) = self.graph.constant(condition) {
            return self.expr(if truth == 0.0 { otherwise } else { then });
        }
        let (then, otherwise) = (self.expr(then)?, self.expr(otherwise)?);
        let (Value::Numbers(a), Value::Numbers(b)) = (&then, &otherwise) else {
            let message = "only numbers, vectors and colours can be chosen while the scene runs";
            let diagnostic = Diagnostic::error("E0404", message, span, "not known at compile time");
            let help = "choose between the numbers that the shape is built from, or use the key `when`";
            return Err(Box::new(diagnostic.with_help(help)));
        };
        Ok(Value::Numbers(a.iter().zip(b).map(|(&a, &b)| self.pick(condition, a, b)).collect()))
    }

    fn pick(&mut self, condition: ValueId, a: ValueId, b: ValueId) -> ValueId {
        match self.graph.ty(a) {
            crate::ops::Ty::Number => {
                let picked = self.graph.select(condition, a, b);
                // Two equal numbers leave nothing to choose.
                let chooses = matches!(self.graph.inst(picked), Inst::Apply { op: Op::Select, .. });
                if chooses && self.graph.rate(condition) == Rate::Point {
                    self.choices.insert(picked);
                }
                picked
            }
            crate::ops::Ty::Bool => {
                let yes = self.graph.apply(Op::And, &[condition, a]);
                let not = self.graph.apply(Op::Not, &[condition]);
                let no = self.graph.apply(Op::And, &[not, b]);
                self.graph.apply(Op::Or, &[yes, no])
            }
        }
    }

    fn comprehension(&mut self, variable: LocalId, over: &Over, body: ExprId) -> Lowered<Value> {
        let items: Vec<Value> = match over {
            Over::List(list) => self.expr(*list)?.list().to_vec(),
            Over::Range(from, to) => {
                let (from, to) = (self.whole_constant(*from)?, self.whole_constant(*to)?);
                let count = u32::try_from((to - from).max(0)).unwrap_or(u32::MAX);
                if count > MAX_UNROLLED {
                    return Err(too_long(self.hir.expr(body).span));
                }
                (from..to).map(|i| self.number(i as f64)).collect()
            }
        };
        let mut list = Vec::with_capacity(items.len());
        for item in items {
            self.environment.bind(variable, item);
            list.push(self.expr(body)?);
        }
        Ok(Value::List(list.into()))
    }

    fn whole_constant(&mut self, id: ExprId) -> Lowered<i64> {
        let span = self.hir.expr(id).span;
        let value = self.expr(id)?.scalar();
        let number = self.compile_time(value, "the length of a list", span)?;
        Ok(number as i64)
    }

    /// The number behind a value that must be a constant.
    pub(crate) fn compile_time(&self, value: ValueId, what: &str, span: Span) -> Lowered<f64> {
        self.graph.constant(value).ok_or_else(|| {
            let message = format!("{what} must be known at compile time");
            Box::new(
                Diagnostic::error("E0405", message, span, "depends on a param, the time or the position")
                    .with_help("write a number or a `let` of numbers here"),
            )
        })
    }

    /// Refuses numbers that are known to be wrong. What a param or the time sets is not known here.
    pub(crate) fn refuse(
        &self,
        values: &[ValueId],
        wrong: fn(f64) -> bool,
        message: &str,
        span: Span,
    ) -> Lowered<()> {
        let help = "change the number, or leave the shape out with the key `when`";
        self.refuse_with_help(values, wrong, message, span, help)
    }

    /// As [`Self::refuse`], with a help line of its own.
    pub(crate) fn refuse_with_help(
        &self,
        values: &[ValueId],
        wrong: fn(f64) -> bool,
        message: &str,
        span: Span,
        help: &str,
    ) -> Lowered<()> {
        let mut known = values.iter().filter_map(|&value| self.graph.constant(value));
        let Some(number) = known.find(|&number| wrong(number)) else { return Ok(()) };
        let diagnostic = Diagnostic::error("E0407", message, span, format!("here it is {number}"));
        Err(Box::new(diagnostic.with_help(help)))
    }

    fn user_function(&mut self, index: usize, args: Vec<Value>, span: Span) -> Lowered<Value> {
        let function = &self.hir.functions[index];
        let params: Vec<LocalId> = function.params.iter().map(|&(local, _)| local).collect();
        let outer = self.environment.clone();
        for (local, arg) in params.into_iter().zip(args) {
            self.environment.bind(local, arg);
        }
        let value = self.expr(function.body);
        self.environment = outer;
        if function.module == ModuleId::LIBRARY {
            // The author sees the call, not the library's text.
            return value.map_err(|mut diagnostic| {
                diagnostic.labels.truncate(1);
                diagnostic.labels.iter_mut().for_each(|label| label.span = span);
                diagnostic
            });
        }
        value
    }

    /// Calls a function value; arguments that it does not take are dropped.
    pub(crate) fn call(&mut self, closure: &Closure, args: &[Value]) -> Lowered<Value> {
        match closure {
            Closure::Constant(value) => Ok(value.clone()),
            Closure::Lambda { params, body, captured } => {
                let outer = std::mem::replace(&mut self.environment, captured.clone());
                for (&local, arg) in params.iter().zip(args) {
                    self.environment.bind(local, arg.clone());
                }
                let value = self.expr(*body);
                self.environment = outer;
                value
            }
        }
    }

    /// Calls a function of numbers.
    pub(crate) fn call_numbers(&mut self, closure: &Closure, args: &[ValueId]) -> Lowered<Value> {
        let args: Vec<Value> = args.iter().map(|&v| Value::Numbers(vec![v])).collect();
        self.call(closure, &args)
    }

    fn local_field(&mut self, point: &LocalPoint, field: LocalField, span: Span) -> Lowered<Value> {
        if field == LocalField::World {
            return Ok(Value::Numbers(point.world.to_vec()));
        }
        point.region.local_field(self, point.world, field, span).map(Value::Numbers)
    }
}

fn equal(graph: &mut crate::ir::graph::Graph, a: ValueId, b: ValueId) -> ValueId {
    if graph.ty(a) == crate::ops::Ty::Number {
        return graph.apply(Op::Equal, &[a, b]);
    }
    let both = graph.apply(Op::And, &[a, b]);
    let either = graph.apply(Op::Or, &[a, b]);
    let neither = graph.apply(Op::Not, &[either]);
    graph.apply(Op::Or, &[both, neither])
}

fn convert(conversion: Conversion, operand: Value, components: usize) -> Value {
    match conversion {
        Conversion::Retype => operand,
        Conversion::Broadcast => Value::Numbers(vec![operand.scalar(); components]),
        Conversion::Constant => Value::Function(Rc::new(Closure::Constant(operand))),
    }
}

fn too_long(span: Span) -> Box<Diagnostic> {
    let message = format!("the scene unrolls to more than {MAX_UNROLLED} expressions");
    Box::new(
        Diagnostic::error("E0401", message, span, "the limit is reached here")
            .with_help("shorten the lists, or call the functions inside them less often"),
    )
}

fn too_deep(span: Span) -> Box<Diagnostic> {
    let message = format!("expressions and calls nest deeper than {MAX_DEPTH}");
    Box::new(
        Diagnostic::error("E0402", message, span, "the limit is reached here")
            .with_help("name an inner part with `let`"),
    )
}
