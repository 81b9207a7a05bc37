//! The grammar's rules in the words of messages.

use super::Rule;
use crate::parse::explain::OPERATOR;

/// What the user would call a rule; empty for rules that help nobody.
pub(super) fn words(rule: Rule) -> &'static str {
    match rule {
        Rule::expr
        | Rule::operand
        | Rule::prefix
        | Rule::negate
        | Rule::not
        | Rule::number
        | Rule::color
        | Rule::boolean
        | Rule::if_expr
        | Rule::paren
        | Rule::list
        | Rule::record
        | Rule::iterate
        | Rule::range
        | Rule::argument => "an expression",
        Rule::infix
        | Rule::add
        | Rule::subtract
        | Rule::multiply
        | Rule::divide
        | Rule::modulo
        | Rule::or
        | Rule::and
        | Rule::union
        | Rule::intersection
        | Rule::equal
        | Rule::not_equal
        | Rule::less_equal
        | Rule::less
        | Rule::greater_equal
        | Rule::greater
        | Rule::postfix
        | Rule::call
        | Rule::member
        | Rule::lambda_tail
        | Rule::range_to => OPERATOR,
        Rule::string => "a string",
        Rule::name => "a name",
        Rule::type_expr | Rule::list_type | Rule::function_type => "a type",
        Rule::entry => "a key",
        Rule::fn_params => "`(`",
        Rule::fn_param => "a parameter",
        Rule::block => "`{`",
        Rule::colon => "`:`",
        Rule::equals => "`=`",
        Rule::arrow => "`->`",
        Rule::kw_let | Rule::binding => "`let`",
        Rule::kw_param => "`param`",
        Rule::kw_fn => "`fn`",
        Rule::kw_in => "`in`",
        Rule::kw_import => "`import`",
        Rule::kw_as => "`as`",
        Rule::kw_iterate => "`iterate`",
        Rule::kw_from => "`from`",
        Rule::kw_while => "`while`",
        Rule::states => "`(`",
        Rule::state => "a name",
        Rule::kw_for | Rule::comprehension => "`for`",
        Rule::kw_if => "`if`",
        Rule::kw_then => "`then`",
        Rule::kw_else => "`else`",
        Rule::EOI
        | Rule::WHITESPACE
        | Rule::word_char
        | Rule::dot
        | Rule::reserved
        | Rule::import_unit
        | Rule::let_unit
        | Rule::param_unit
        | Rule::fn_unit
        | Rule::entry_unit => "",
    }
}
